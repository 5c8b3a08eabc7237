# SPDX-License-Identifier: BSD-3-Clause
# Writes files as C arrays: embed.py OUTPUT NAME=FILE...   (optla_rig_file_NAME_, see rig_files.h)
import os
import sys

with open(sys.argv[1], "w", encoding="utf-8") as out:
    out.write('#include "report/rig_files.h"\n')
    for argument in sys.argv[2:]:
        name, path = argument.split("=", 1)
        with open(path, "rb") as f:
            data = f.read()
        out.write("\nstatic const unsigned char %s[] = {" % name)
        for k, byte in enumerate(data):
            out.write("%s%d," % ("\n" if k % 24 == 0 else "", byte))
        out.write("0};\nconst optla_rig_file optla_rig_file_%s_ = {\"%s\", %s, %d};\n" % (name, os.path.basename(path), name, len(data)))

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the golden images of this folder. Needs python3-numpy, python3-tifffile and oiiotool (openimageio-tools).

Run it only to add files: the tests read what is committed. No file is made by Optla or by the library that Optla reads it with,
where that could be avoided: PNG, PFM, DNG and the plain EXR are put together here byte by byte from their specifications, TIFF comes
from tifffile (Python) and, for compressions which that lacks, from oiiotool; the other EXR files come from OpenEXR's C++ library
(through oiiotool), of which OpenEXRCore is an independent rewrite.

Every image has 7 x 5 pixels and samples of a formula (u8, u16, half below), so a test knows what must come out without a second file.
"""
import os, struct, subprocess, sys, tempfile, zlib
import numpy as np
import tifffile

W, H = 7, 5
os.chdir(os.path.dirname(os.path.abspath(__file__)))


def u8(x, y, c): return (37 * x + 59 * y + 101 * c + 3) % 256
def u16(x, y, c): return (4801 * x + 9973 * y + 21001 * c + 77) % 65536
def half(x, y, c): return (x + 8 * y + 40 * c - 60) / 4  # exact in 16-bit floats


def array(f, channels, dtype):
    return np.array([[[f(x, y, c) for c in range(channels)] for x in range(W)] for y in range(H)], dtype=dtype)


def write(name, data):
    assert len(data) < 4096, (name, len(data))
    open(name, "wb").write(data)


# ---- PNG: ISO/IEC 15948 ----

def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def pack_row(samples, bits):
    if bits == 16:
        return b"".join(struct.pack(">H", s) for s in samples)
    text = "".join(format(s, "0%db" % bits) for s in samples)
    text += "0" * (-len(text) % 8)
    return bytes(int(text[k:k + 8], 2) for k in range(0, len(text), 8))


ADAM7 = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]


def png(name, colour, bits, channels, f, extra=b"", interlaced=False, split=None):
    raw = b""
    for x0, y0, dx, dy in ADAM7 if interlaced else [(0, 0, 1, 1)]:
        xs = range(x0, W, dx)
        for y in range(y0, H, dy):
            if xs:
                raw += b"\0" + pack_row([f(x, y, c) for x in xs for c in range(channels)], bits)
    body = zlib.compress(raw)
    parts = [body] if not split else [body[k:k + split] for k in range(0, len(body), split)]
    write(name, b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", W, H, bits, colour, 0, 0, int(interlaced))) + extra +
          b"".join(chunk(b"IDAT", p) for p in parts) + chunk(b"IEND", b""))


def make_png():
    for bits in 1, 2, 4:
        png("grey%d.png" % bits, 0, bits, 1, lambda x, y, c: u8(x, y, c) % (1 << bits))
    png("grey8.png", 0, 8, 1, u8)
    png("grey16.png", 0, 16, 1, u16, split=9)
    png("rgb8-interlaced.png", 2, 8, 3, u8, interlaced=True)
    png("rgb16.png", 2, 16, 3, u16)
    png("rgb16-interlaced.png", 2, 16, 3, u16, interlaced=True)
    png("grey-alpha16.png", 4, 16, 2, u16)
    png("rgba8.png", 6, 8, 4, u8)
    palette = chunk(b"PLTE", bytes(u8(k, 0, c) for k in range(4) for c in range(3))) + chunk(b"tRNS", bytes([255, 128]))
    png("palette2-alpha.png", 3, 2, 1, lambda x, y, c: (x + y) % 4, extra=palette)
    transparent = chunk(b"tRNS", struct.pack(">HHH", *(u16(2, 1, c) for c in range(3))))
    png("rgb16-transparent.png", 2, 16, 3, u16, extra=transparent)


# ---- PFM ----

def make_pfm():
    for name, channels, order in ("grey-big.pfm", 1, ">"), ("rgb-little.pfm", 3, "<"):
        head = "%s\n%d %d\n%s\n" % ("PF" if channels == 3 else "Pf", W, H, "1.0" if order == ">" else "-1.0")
        rows = b"".join(struct.pack(order + "f", half(x, y, c)) for y in reversed(range(H)) for x in range(W) for c in range(channels))
        write(name, head.encode() + rows)


# ---- EXR, uncompressed scanlines: openexr.com, "OpenEXR File Layout" ----

def make_plain_exr():
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(data)) + data
    channels = b"".join(n + b"\0" + struct.pack("<iBBBBii", 2, 0, 0, 0, 0, 1, 1) for n in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<iiii", 0, 0, W - 1, H - 1)
    head = b"\x76\x2f\x31\x01\2\0\0\0" + attribute(b"channels", b"chlist", channels) + attribute(b"compression", b"compression", b"\0")
    head += attribute(b"dataWindow", b"box2i", window) + attribute(b"displayWindow", b"box2i", window)
    head += attribute(b"lineOrder", b"lineOrder", b"\0") + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)) + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
    head += b"\0"
    line = 8 + 12 * W
    table = b"".join(struct.pack("<Q", len(head) + 8 * H + y * line) for y in range(H))
    lines = b"".join(struct.pack("<ii", y, 12 * W) + b"".join(struct.pack("<f", half(x, y, c)) for c in (2, 1, 0) for x in range(W))
                     for y in range(H))
    write("rgb-float-plain.exr", head + table + lines)


# ---- DNG: TIFF 6.0, TIFF/EP (colour filter array), DNG 1.4; RGGB, 16 bits, black level 512, white level 16000; LibRaw refuses
# pictures of less than 22 pixels ----

def make_dng():
    counts = struct.pack("<%dH" % (28 * 24), *(512 + u16(x, y, 0) % 15000 for y in range(24) for x in range(28)))
    make, model = b"Optla\0", b"Synthetic\0"
    entries = [(254, 4, 1, struct.pack("<I", 0)), (256, 4, 1, struct.pack("<I", 28)), (257, 4, 1, struct.pack("<I", 24)),
               (258, 3, 1, struct.pack("<H", 16)), (259, 3, 1, struct.pack("<H", 1)), (262, 3, 1, struct.pack("<H", 32803)),
               (271, 2, len(make), make), (272, 2, len(model), model), (273, 4, 1, None), (274, 3, 1, struct.pack("<H", 1)),
               (277, 3, 1, struct.pack("<H", 1)), (278, 4, 1, struct.pack("<I", 24)), (279, 4, 1, struct.pack("<I", len(counts))),
               (284, 3, 1, struct.pack("<H", 1)), (33421, 3, 2, struct.pack("<HH", 2, 2)), (33422, 1, 4, bytes([0, 1, 1, 2])),
               (50706, 1, 4, bytes([1, 4, 0, 0])), (50707, 1, 4, bytes([1, 1, 0, 0])), (50708, 2, len(model), model),
               (50714, 3, 1, struct.pack("<H", 512)), (50717, 4, 1, struct.pack("<I", 16000)),
               (50721, 10, 9, struct.pack("<18i", *sum(([int(k % 4 == 0), 1] for k in range(9)), []))),
               (50728, 5, 3, struct.pack("<6I", 1, 1, 1, 1, 1, 1))]
    after = 8 + 2 + 12 * len(entries) + 4
    extra = b""
    where = after + sum(len(d) + len(d) % 2 for _, _, _, d in entries if d and len(d) > 4)
    ifd = struct.pack("<H", len(entries))
    for tag, kind, count, data in entries:
        if data is None:
            data = struct.pack("<I", where)
        if len(data) <= 4:
            ifd += struct.pack("<HHI", tag, kind, count) + data.ljust(4, b"\0")
        else:
            ifd += struct.pack("<HHII", tag, kind, count, after + len(extra))
            extra += data + b"\0" * (len(data) % 2)
    write("bayer.dng", b"II*\0" + struct.pack("<I", 8) + ifd + struct.pack("<I", 0) + extra + counts)


# ---- TIFF by tifffile ----

def make_tiff():
    def save(name, a, **how):
        with tempfile.NamedTemporaryFile(suffix=".tif") as t:
            tifffile.imwrite(t.name, a, metadata=None, software=None, **how)
            write(name, open(t.name, "rb").read())
    save("rgb8.tif", array(u8, 3, np.uint8), photometric="rgb")
    save("grey16-big.tif", array(u16, 1, np.uint16)[..., 0], photometric="minisblack", byteorder=">", rowsperstrip=2)
    save("grey8-white.tif", array(u8, 1, np.uint8)[..., 0], photometric="miniswhite")
    save("rgb16-deflate.tif", array(u16, 3, np.uint16), photometric="rgb", compression="zlib", predictor=True, rowsperstrip=3)
    save("rgba16.tif", array(u16, 4, np.uint16), photometric="rgb", extrasamples=["unassalpha"])
    save("rgb-float-planes.tif", np.moveaxis(array(half, 3, np.float32), 2, 0).copy(), photometric="rgb", planarconfig="separate", rowsperstrip=2)
    save("rgb16-bigtiff.tif", array(u16, 3, np.uint16), photometric="rgb", bigtiff=True)
    save("grey16-tiles.tif", array(u16, 1, np.uint16)[..., 0], photometric="minisblack", tile=(16, 16), compression="zlib")
    save("rgb-float-big-tiles.tif", array(half, 3, np.float32), photometric="rgb", tile=(16, 16), byteorder=">")
    with tempfile.NamedTemporaryFile(suffix=".tif") as t:  # as some scanners write: a make, and a smaller picture in a sub-directory
        with tifffile.TiffWriter(t.name) as w:
            w.write(array(u8, 3, np.uint8), photometric="rgb", metadata=None, software=None, subifds=1, extratags=[(271, 2, 5, b"Maker", True)])
            w.write(array(u8, 3, np.uint8)[::2, ::2], photometric="rgb", metadata=None, software=None)
        write("rgb8-make.tif", open(t.name, "rb").read())
    save("int32.tif", array(u16, 1, np.int32)[..., 0], photometric="minisblack")


# ---- files of oiiotool ----

def oiio(name, *how):
    with tempfile.TemporaryDirectory() as d:
        out = os.path.join(d, name)
        subprocess.run(["oiiotool", *how, "-o", out], check=True)
        write(name, open(out, "rb").read())


def make_oiio():
    oiio("rgb16-lzw.tif", "rgb16-deflate.tif", "--compression", "lzw")
    oiio("rgb8-packbits.tif", "rgb8.tif", "--compression", "packbits")
    plain = "rgb-float-plain.exr"
    for compression in "none", "rle", "zips", "zip", "piz", "pxr24":
        oiio("rgb-half-%s.exr" % compression, plain, "-d", "half", "--compression", compression)
    oiio("rgb-half-tiles.exr", plain, "-d", "half", "--tile", "4", "4", "--compression", "zip")
    oiio("rgb-float-piz.exr", plain, "--compression", "piz")
    oiio("rgba-layers.exr", plain, "--ch", "R,G,B,A=0.25,Z=9,left.R=5", "-d", "half", "--compression", "zip")
    oiio("y-half.exr", plain, "--ch", "Y=R", "-d", "half", "--compression", "none")
    oiio("y-uint.exr", "grey16.png", "--chnames", "Y", "-d", "uint32", "--compression", "none")
    oiio("z-only.exr", plain, "--ch", "Z=R", "-d", "half", "--compression", "none")
    # The picture at (2, 1) of a display window of 10 x 8, and cut by one of 4 x 3 at (1, 1).
    oiio("window-inside.exr", plain, "-d", "half", "--origin", "+2+1", "--fullsize", "10x8+0+0", "--compression", "zip")
    oiio("window-cut.exr", plain, "-d", "half", "--fullsize", "4x3+1+1", "--compression", "none")
    oiio("two-parts.exr", plain, "-d", "half", "y-half.exr", "--siappend", "--compression", "none")
    oiio("deep.exr", "rgba-layers.exr", "--ch", "R,G,B,A,Z", "--deepen", "--compression", "zips")


def make_npy():
    for name, a in (("rgb16.npy", array(u16, 3, np.uint16)), ("grey8.npy", array(u8, 1, np.uint8)[..., 0]),
                    ("rgb-float-fortran.npy", np.asfortranarray(array(half, 3, np.float32))),
                    ("grey-double-big.npy", array(half, 1, ">f8")[..., 0]), ("int64.npy", array(u16, 1, np.int64)[..., 0])):
        np.save(name, a)
        assert os.path.getsize(name) < 4096


make_png()
make_pfm()
make_plain_exr()
make_dng()
make_tiff()
make_npy()
make_oiio()

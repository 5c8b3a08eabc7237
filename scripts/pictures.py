#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Remakes the pictures of README.md in docs/pictures/ from the demonstration's page, packed as small as PNG goes.

  make && scripts/pictures.py [BUILD]

They show the built-in corner only: real photos belong to their owners and stay out of the repository.
"""
import os
import struct
import subprocess
import sys
import tempfile
import zlib

PICTURES = {'components.png': 'components.png', 'relit.png': 'relit.png', 'errors.png': 'errors.png', 'inverse.png': 'inverse.png',
            'dual.png': 'dual.png'}
LIMIT = 200_000


def chunks(data):
    at = 8
    while at < len(data):
        length, = struct.unpack('>I', data[at:at + 4])
        yield data[at + 4:at + 8], data[at + 8:at + 8 + length]
        at += 12 + length


def chunk(kind, data):
    return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))


def unfilter(raw, stride, bpp):
    """Rows of samples from PNG's filtered rows (PNG specification, section 9)."""
    rows, before = [], bytearray(stride)
    for at in range(0, len(raw), stride + 1):
        kind, row = raw[at], bytearray(raw[at + 1:at + 1 + stride])
        for i in range(stride):
            a = row[i - bpp] if i >= bpp else 0
            b = before[i]
            c = before[i - bpp] if i >= bpp else 0
            if kind == 1:
                row[i] = row[i] + a & 255
            elif kind == 2:
                row[i] = row[i] + b & 255
            elif kind == 3:
                row[i] = row[i] + (a + b) // 2 & 255
            elif kind == 4:
                p = a + b - c
                pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                row[i] = row[i] + (a if pa <= pb and pa <= pc else b if pb <= pc else c) & 255
        rows.append(row)
        before = row
    return rows


def palette(rows):
    """(palette, rows of indices) of an RGB picture; colours are rounded to multiples of 1, 2, 4, ... until 256 are enough."""
    for step in (1, 2, 4, 8, 16):
        coarse = [bytes(min(255, (v + step // 2) // step * step) for v in r) for r in rows]
        colours = sorted({r[i:i + 3] for r in coarse for i in range(0, len(r), 3)})
        if len(colours) <= 256:
            index = {c: k for k, c in enumerate(colours)}
            return b''.join(colours), [bytearray(index[r[i:i + 3]] for i in range(0, len(r), 3)) for r in coarse]
    raise ValueError('too many colours')


def pack(path):
    """The same picture with the row filter (none, or up) that packs best, and the texts that say how it was made. If that is too
    large, with a palette."""
    with open(path, 'rb') as file:
        parts = list(chunks(file.read()))
    header = parts[0][1]
    width, _, depth, colour = struct.unpack('>IIBB', header[:10])
    bpp = {0: 1, 2: 3, 4: 2, 6: 4}[colour] * depth // 8
    rows = unfilter(zlib.decompress(b''.join(d for k, d in parts if k == b'IDAT')), width * bpp, bpp)
    texts = b''.join(chunk(k, d) for k, d in parts if k in (b'tEXt', b'iTXt'))

    def encode(header, extra, rows):
        above = [bytearray(len(rows[0]))] + rows[:-1]
        plain = b''.join(b'\0' + r for r in rows)
        up = b''.join(b'\2' + bytes(x - y & 255 for x, y in zip(r, a)) for r, a in zip(rows, above))
        data = min((zlib.compress(raw, 9) for raw in (plain, up)), key=len)
        return b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) + extra + texts + chunk(b'IDAT', data) + chunk(b'IEND', b'')

    png = encode(header, b'', rows)
    if len(png) > LIMIT and bpp == 3:
        colours, rows = palette(rows)
        png = encode(header[:8] + bytes([8, 3]) + header[10:], chunk(b'PLTE', colours), rows)
    return png


def main():
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..')
    build = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.path.join(root, 'build'))
    target = os.path.join(root, 'docs', 'pictures')
    os.makedirs(target, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        # A relative name, and no date, so that the same program makes the same bytes again
        subprocess.run([os.path.join(build, 'tools', 'optla'), 'demo', '-q', '-o', 'demo'], cwd=folder, check=True,
                       env={**os.environ, 'SOURCE_DATE_EPOCH': '0'})
        for source, name in PICTURES.items():
            data = pack(os.path.join(folder, 'demo', 'corner', source))
            if len(data) > LIMIT:
                sys.exit(f'{name} has {len(data)} bytes: more than {LIMIT}')
            with open(os.path.join(target, name), 'wb') as file:
                file.write(data)
            print(f'docs/pictures/{name}: {len(data)} bytes')


if __name__ == '__main__':
    main()

"""Good files that fuzz targets begin with. usage: make_seeds.py png | stl | hdf5 FOLDER REPOSITORY"""

import os
import struct
import sys
import zlib


def png(width, height, depth, rows, more=b"", interlaced=0):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", width, height, depth, 0, 0, 0, interlaced)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + more +
            chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))


def pngs():
    transparent = struct.pack(">I", 2) + b"tRNS\0\0" + struct.pack(">I", zlib.crc32(b"tRNS\0\0"))
    yield "grey.png", png(3, 2, 8, [b"\0\x7f\xff", b"\xff\0\0"])
    yield "wide.png", png(2, 1, 16, [b"\x80\0\xff\xff"])
    yield "bits.png", png(8, 2, 1, [b"\xa0", b"\x05"])
    yield "transparent.png", png(2, 1, 8, [b"\0\xff"], transparent)
    yield "interlaced.png", png(1, 1, 8, [b"\x40"], interlaced=1)


CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def stls():
    text, binary = "solid tetrahedron\n", b"solid binary".ljust(80, b" ") + struct.pack("<I", len(FACES))
    for face in FACES:
        text += "facet normal 0 0 0\nouter loop\n"
        binary += b"\0" * 12
        for corner in face:
            text += "vertex {} {} {}\n".format(*CORNERS[corner])
            binary += struct.pack("<3f", *CORNERS[corner])
        text += "endloop\nendfacet\n"
        binary += b"\0\0"
    text += "endsolid tetrahedron\n"
    yield "text.stl", text.encode()
    yield "capitals.stl", text.upper().replace("\n", "\r\n").encode()
    yield "two.stl", (text + text.replace("1", "2")).encode()
    yield "binary.stl", binary


def hdf5s(folder, root):
    import h5py
    import numpy as np
    path = os.path.join(folder, "density.h5")
    with h5py.File(path, "w") as file:
        file["density"] = np.array([[0, 0.5, 1], [-1, 0.25, 1]])
    source = os.path.join(root, "data", "tables", "arris_x220_planar.h5")
    with h5py.File(source, "r") as shipped, h5py.File(os.path.join(folder, "table.h5"), "w") as table:
        points = len(shipped["travel"])

        def copy(name, item):
            if isinstance(item, h5py.Dataset):
                data = item[()][:4] if len(item) == points else item[()]
                table[name] = np.zeros(0) if name.startswith("shapes/") else data
                table[name].attrs["unit"] = item.attrs["unit"]
        shipped.visititems(copy)
        table.require_group("provenance").attrs["note"] = "four points"
    with h5py.File(os.path.join(root, "data", "wings", "arris_x220", "wing_table.h5"), "r") as shipped, \
            h5py.File(os.path.join(folder, "wing.h5"), "w") as table:
        for name, value in shipped.attrs.items():
            table.attrs[name] = value
        for name, item in shipped.items():
            if isinstance(item, h5py.Dataset):
                table[name] = item[()][:4]
                table[name].attrs["unit"] = item.attrs["unit"]
        table.require_group("provenance").attrs["note"] = "four rows"


def main():
    kind, folder, root = sys.argv[1:4]
    if kind == "hdf5":
        hdf5s(folder, root)
        return
    for name, content in pngs() if kind == "png" else stls():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(content)


if __name__ == "__main__":
    main()

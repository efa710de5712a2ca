"""Writes and reads depth maps with NumPy, OpenCV, tifffile and OpenEXR, for independent_depth.rs.

`check FOLDER`: what is in FOLDER/ours.* must be the floats of FOLDER/truth.f32 (7 columns).
`write FOLDER`: writes those floats in every form we claim to read, one file each.
"""

import os
import sys

import cv2
import numpy as np
import OpenEXR
import tifffile

what, folder = sys.argv[1:]
path = lambda name: os.path.join(folder, name)
truth = np.fromfile(path("truth.f32"), "<f4").reshape(-1, 7)
millimetres = np.round(truth * 1000)

if what == "check":
    plain = lambda name: cv2.imread(path(name), cv2.IMREAD_UNCHANGED)
    seen = {
        "numpy npy": np.load(path("ours.npy")),
        "tifffile tiff": tifffile.imread(path("ours.tiff")),
        "opencv tiff": plain("ours.tiff"),
        "openexr exr": OpenEXR.File(path("ours.exr")).channels()["Z"].pixels,
        "opencv pfm": plain("ours.pfm"),
    }
    for name, found in seen.items():
        assert found is not None, name + " cannot be read"
        assert found.dtype == np.float32 and np.array_equal(found.squeeze(), truth), (name, found.shape)
    png = plain("ours.png")
    assert png.dtype == np.uint16 and np.array_equal(png, millimetres), "opencv png"
else:
    words, bytes_ = millimetres.astype(np.uint16), np.round(truth).astype(np.uint8)
    for order in "<>":
        for kind in ("f4", "f8"):
            np.save(path(f"metres_{ord(order)}_{kind}.npy"), truth.astype(order + kind))
        np.save(path(f"millimetres_{ord(order)}.npy"), words.astype(order + "u2"))
    np.save(path("metres_fortran.npy"), np.asfortranarray(truth))
    np.save(path("whole.npy"), bytes_)
    for name, code in (("none", 1), ("lzw", 5), ("deflate", 8)):
        flags = [cv2.IMWRITE_TIFF_COMPRESSION, code]
        assert cv2.imwrite(path(f"metres_{name}.tiff"), truth, flags)
        assert cv2.imwrite(path(f"millimetres_{name}.tiff"), words, flags)
    tifffile.imwrite(path("metres_zlib_big.tif"), truth, compression="zlib", byteorder=">")
    tifffile.imwrite(path("whole.tif"), bytes_)
    assert cv2.imwrite(path("millimetres.png"), words)
    assert cv2.imwrite(path("whole.png"), bytes_)
    compressions = {"none": OpenEXR.NO_COMPRESSION, "zip": OpenEXR.ZIP_COMPRESSION, "piz": OpenEXR.PIZ_COMPRESSION}
    for name, code in compressions.items():
        header = {"compression": code, "type": OpenEXR.scanlineimage}
        OpenEXR.File(header, {"Z": truth}).write(path(f"metres_{name}.exr"))
        OpenEXR.File(header, {"Y": truth.astype(np.float16)}).write(path(f"half_{name}.exr"))
    OpenEXR.File(header, {"A": truth * 0, "Z": truth, "R": truth * 0}).write(path("metres_among.exr"))
    assert cv2.imwrite(path("metres.pfm"), truth)
    with open(path("metres_big.pfm"), "wb") as file:
        file.write(b"Pf\n7 %d\n1.0\n" % len(truth) + truth[::-1].astype(">f4").tobytes())

"""Writes and reads depth maps with NumPy, OpenCV and tifffile, for independent_depth.rs.

`check FOLDER`: what is in FOLDER/ours.* must be the floats of FOLDER/truth.f32 (7 columns).
`write FOLDER`: writes those floats in every form we claim to read, one file each.
"""

import os
import sys

os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
import cv2
import numpy as np
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
        "opencv exr": plain("ours.exr"),
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
    assert cv2.imwrite(path("metres.exr"), truth)
    assert cv2.imwrite(path("half.exr"), truth, [cv2.IMWRITE_EXR_TYPE, cv2.IMWRITE_EXR_TYPE_HALF])
    assert cv2.imwrite(path("metres.pfm"), truth)
    with open(path("metres_big.pfm"), "wb") as file:
        file.write(b"Pf\n7 %d\n1.0\n" % len(truth) + truth[::-1].astype(">f4").tobytes())

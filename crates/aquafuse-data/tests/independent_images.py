"""Writes and reads images with Pillow, OpenCV and tifffile, for independent_images.rs.

`write FOLDER`: one file of each kind we claim to read, and for each what an independent decoder makes of it:
FOLDER/NAME.npy, RGB or RGBA, 8 or 16 bits.
`check FOLDER`: what is in FOLDER/ours.* must be the pixels of FOLDER/ours.npy, and hold orientation 6, 300 dpi
and a colour profile.
`orientations FOLDER`: FOLDER/N.EXT (N from 1 to 8), turned as a viewer turns them, must all look like FOLDER/upright.npy.
"""

import io
import os
import sys

import cv2
import numpy as np
import tifffile
from PIL import Image, ImageCms, ImageOps

what, folder = sys.argv[1:]
path = lambda name: os.path.join(folder, name)
y, x = np.mgrid[:40, :56]
rgb = np.stack([4 * x, 6 * y, 120 + x + y], axis=-1).astype(np.uint8)
alpha = (3 * x + 2 * y).astype(np.uint8)
words = rgb.astype(np.uint16) * 257 + (x * y)[..., None].astype(np.uint16) % 257


def keep(name, expected):
    np.save(path(name + ".npy"), np.ascontiguousarray(expected))


def through_pillow(name, image, expected=None, **how):
    image.save(path(name), **how)
    keep(name, np.array(Image.open(path(name)).convert("RGB")) if expected is None else expected)


if what == "write":
    picture = Image.fromarray(rgb)
    grey = Image.fromarray(rgb[..., 0])
    transparent = Image.fromarray(np.dstack([rgb, alpha]))
    rgba = np.dstack([rgb, alpha])
    of_grey = np.repeat(rgb[..., :1], 3, axis=-1)
    for sampling in (0, 1, 2):
        through_pillow(f"sampling{sampling}.jpg", picture, quality=92, subsampling=sampling)
    through_pillow("progressive.jpg", picture, quality=92, progressive=True)
    through_pillow("restarts.jpg", picture, quality=92, restart_marker_rows=1)
    through_pillow("grey.jpg", grey, quality=95)
    through_pillow("cmyk.jpg", picture.convert("CMYK"), quality=95)
    through_pillow("rgb.png", picture, rgb)
    through_pillow("grey.png", grey, of_grey)
    through_pillow("grey_alpha.png", Image.merge("LA", [grey, Image.fromarray(alpha)]), np.dstack([of_grey, alpha]))
    through_pillow("rgba.png", transparent, rgba)
    palette = picture.quantize(17)
    through_pillow("palette.png", palette, np.array(palette.convert("RGB")))
    through_pillow("four_bits.png", picture.quantize(9), bits=4)
    through_pillow("one_bit.png", grey.convert("1"), np.repeat(np.array(grey.convert("1"), np.uint8)[..., None] * 255, 3, -1))
    palette.save(path("see_through.png"), transparency=3)
    keep("see_through.png", np.array(Image.open(path("see_through.png")).convert("RGBA")))
    cv2.imwrite(path("words.png"), words[..., ::-1])
    keep("words.png", words)
    cv2.imwrite(path("words_alpha.png"), np.dstack([words[..., ::-1], words[..., 0]]))
    keep("words_alpha.png", np.dstack([words, words[..., 0]]))
    through_pillow("lossless.webp", picture, rgb, lossless=True)
    through_pillow("lossy.webp", picture, quality=90)
    through_pillow("alpha.webp", transparent, rgba, lossless=True, exact=True)
    through_pillow("plain.bmp", picture, rgb)
    through_pillow("palette.bmp", palette, np.array(palette.convert("RGB")))
    through_pillow("one.gif", palette, np.array(palette.convert("RGB")))
    for name, how in {"none": None, "lzw": "tiff_lzw", "deflate": "tiff_adobe_deflate", "packbits": "packbits"}.items():
        through_pillow(f"{name}.tif", picture, rgb, compression=how)
    through_pillow("rgba.tif", transparent, rgba)
    through_pillow("grey.tif", grey, of_grey)
    tifffile.imwrite(path("words.tif"), words, photometric="rgb")
    keep("words.tif", words)
    tifffile.imwrite(path("big_endian.tif"), words, photometric="rgb", byteorder=">")
    keep("big_endian.tif", words)
    tifffile.imwrite(path("bigtiff.tif"), rgb, photometric="rgb", bigtiff=True)
    keep("bigtiff.tif", rgb)
    tifffile.imwrite(path("tiles.tif"), rgb, photometric="rgb", tile=(16, 16))
    keep("tiles.tif", rgb)
    tifffile.imwrite(path("planes.tif"), np.moveaxis(rgb, -1, 0), photometric="rgb", planarconfig="separate")
    keep("planes.tif", rgb)
    floats = (words / 65535).astype(np.float32)
    tifffile.imwrite(path("floats.tif"), floats, photometric="rgb")
    keep("floats.tif", floats)
    # One with everything that has to be carried over: a camera's fields, GPS, resolution, profile.
    exif = Image.Exif()
    exif[0x010F], exif[0x0112] = "A camera", 6
    exif.get_ifd(0x8769)[0x9003] = "2024:05:06 07:08:09"
    exif.get_ifd(0x8825)[1] = "N"
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    for name in ("carried.jpg", "carried.png", "carried.webp", "carried.tif"):
        more = {"quality": 100, "subsampling": 0} if name.endswith("jpg") else {}
        more |= {"lossless": True} if name.endswith("webp") else {"dpi": (300, 300)}
        picture.save(path(name), exif=exif, icc_profile=profile, **more)
        # Pillow turns a TIFF upright when it decodes it.
        keep(name, rgb if name.endswith("tif") else np.array(Image.open(path(name)).convert("RGB")))
elif what == "check":
    truth = np.load(path("ours.npy"))
    for name in sorted(os.listdir(folder)):
        if name.endswith(".npy"):
            continue
        found = Image.open(path(name))
        exif = found.getexif()
        # Pillow turns a TIFF upright when it decodes it.
        stored = tifffile.imread(path(name)) if name.endswith("tif") else np.array(found)
        loss = np.abs(stored.astype(int) - truth).max()
        assert loss <= (12 if name.endswith("jpg") else 0), (name, loss)
        assert exif[0x010F].rstrip("\0") == "A camera" and exif[0x0112] == 6, (name, dict(exif))
        # Into TIFF, Pillow writes the camera's fields of the main directory only.
        if "from_tif" not in name:
            assert exif.get_ifd(0x8769)[0x9003].rstrip("\0") == "2024:05:06 07:08:09", name
            assert exif.get_ifd(0x8825)[1].rstrip("\0") == "N", name
        profile = ImageCms.ImageCmsProfile(io.BytesIO(found.info["icc_profile"]))
        assert "sRGB" in ImageCms.getProfileDescription(profile), name
        # WebP has no place for a resolution but EXIF.
        if "webp" not in name:
            assert np.allclose([float(value) for value in found.info["dpi"]], 300, atol=0.5), (name, found.info["dpi"])
else:
    upright = np.load(path("upright.npy")).astype(int)
    seen = 0
    for name in sorted(os.listdir(folder)):
        if name[0] in "12345678":
            image = np.array(ImageOps.exif_transpose(Image.open(path(name)))).astype(int)
            assert image.shape == upright.shape and np.abs(image - upright).mean() < 3, (name, image.shape)
            seen += 1
    assert seen == 8 * 4, seen

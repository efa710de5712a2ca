"""Folders of photographs for `fuse`, and scenes for `scene fuse`, varied as their users' are: what is passed over without a
word.
"""

import json

from sets import Set, picture

STUBS = ["HEIC", "avif", "ARW", "dng", "CR2", "nef", "GPR", "jp2", "raf", "psd", "jxl"]
READ = ["jpg", "JPEG", "jfif", "MPO", "png", "tiff", "webp", "bmp"]


def photographs():
    def folder(*extensions, name="dive"):
        made = Set()
        for number, extension in enumerate(extensions):
            path = f"{name}{number}.{extension}"
            if extension in STUBS:
                made.other(path, b"\0\0\0\x18ftypheic")
                made.images.add(path)
            else:
                made.image(path)
        return made

    return {
        "camera": folder("jpg", "JPEG", "ARW"),
        "phone": folder("HEIC", "jpg", "jfif"),
        "stereo": folder("MPO", "jpg"),
        "action": folder("GPR", "jpg"),
        "mixed": folder(*READ, *STUBS),
        "scans": folder("tiff", "bmp", "webp", "png"),
        "raw_alone": folder("CR2", "nef"),
    }


def frames():
    for number in range(4):
        turn = [[1, 0, 0, number / 10], [0, 1, 0, 0], [0, 0, 1, 2], [0, 0, 0, 1]]
        yield number, turn


def nerfstudio(path_of, model="OPENCV", **more):
    poses = [{"file_path": path_of(number), "transform_matrix": turn} for number, turn in frames()]
    head = {"camera_model": model, "fl_x": 80.0, "fl_y": 80.0, "cx": 48.0, "cy": 36.0, "w": 96, "h": 72}
    return json.dumps(head | more | {"frames": poses}).encode()


def blender(path_of):
    poses = [{"file_path": path_of(number), "rotation": 0.01, "transform_matrix": turn} for number, turn in frames()]
    return json.dumps({"camera_angle_x": 1.08, "frames": poses}).encode()


def scenes():
    """Scenes by their names; what `scene fuse` is given is the folder."""

    def scene(images, cameras, at="transforms.json"):
        made = Set().label(cameras, at)
        return made.image(*(images(number) for number in range(4)))

    name = lambda number: f"frame_{number:05}.png"
    inside = lambda number: f"images/{name(number)}"
    missing = scene(inside, nerfstudio(inside))
    del missing.files["images/frame_00002.png"]
    missing.images.discard("images/frame_00002.png")
    return {
        "nerfstudio": scene(inside, nerfstudio(inside)),
        "nerfstudio_beside": scene(name, nerfstudio(name)),
        "nerfstudio_dots": scene(inside, nerfstudio(lambda number: f"./{inside(number)}")),
        "nerfstudio_windows": scene(inside, nerfstudio(lambda number: f"images\\{name(number)}")),
        "nerfstudio_upper": scene(lambda number: f"Images/{name(number)}", nerfstudio(inside)),
        "nerfstudio_absolute": scene(inside, nerfstudio(lambda number: f"/home/me/reef/{inside(number)}")),
        "nerfstudio_no_size": scene(inside, nerfstudio(inside, w=None, h=None)),
        "nerfstudio_fisheye": scene(inside, nerfstudio(inside, "OPENCV_FISHEYE", k1=0.1, k2=0.01)),
        "nerfstudio_missing": missing,
        "nerfstudio_masks": scene(inside, nerfstudio(inside)).mask(*(f"masks/{name(number)}" for number in range(4))),
        "nerfstudio_pyramid": scene(inside, nerfstudio(inside)).other("images_2/frame_00000.png", picture("a.png")),
        "blender": scene(lambda number: f"train/r_{number}.png", blender(lambda number: f"./train/r_{number}"), "transforms_train.json"),
        "blender_beside": scene(lambda number: f"r_{number}.png", blender(lambda number: f"./r_{number}"), "transforms_train.json"),
        "instant_ngp": scene(inside, nerfstudio(inside, "PINHOLE", aabb_scale=16, camera_angle_x=1.08)),
        "no_cameras": scene(inside, b"{}"),
    }

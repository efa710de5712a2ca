"""Writes a log of a robot by `rosbags`, or reads two by `rosbags` and by `mcap`.

    python bags.py write FOLDER             FOLDER/FOLDER.mcap with images, compressed images and a temperature
    python bags.py read BEFORE AFTER        two such folders: images have changed and are whole, all else is the same
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from PIL import Image
from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
SIZE = (48, 64)
FRAMES = 3


def picture(seed: int) -> np.ndarray:
    """A veil over a floor of coloured squares."""
    rows = np.linspace(0, 1, SIZE[0])[:, None, None]
    squares = np.random.default_rng(seed).uniform(0, 255, (SIZE[0] // 16, SIZE[1] // 16, 3))
    floor = squares.repeat(16, axis=0).repeat(16, axis=1)
    return (floor * rows + np.array([20, 110, 160]) * (1 - rows)).astype(np.uint8)


def header(seconds: int):
    time = STORE.types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=7)
    return STORE.types["std_msgs/msg/Header"](stamp=time, frame_id="camera")


def write(folder: Path) -> None:
    kinds = {
        "/image": "sensor_msgs/msg/Image",
        "/packed": "sensor_msgs/msg/CompressedImage",
        "/temperature": "sensor_msgs/msg/Temperature",
    }
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        topics = {topic: writer.add_connection(topic, kind, typestore=STORE) for topic, kind in kinds.items()}
        for frame in range(FRAMES):
            pixels = picture(frame)
            file = io.BytesIO()
            Image.fromarray(pixels).save(file, "JPEG", quality=95)
            messages = {
                "/image": dict(
                    height=SIZE[0], width=SIZE[1], encoding="bgr8", is_bigendian=0, step=3 * SIZE[1],
                    data=pixels[..., ::-1].reshape(-1),
                ),
                "/packed": dict(format="jpeg", data=np.frombuffer(file.getvalue(), np.uint8)),
                "/temperature": dict(temperature=11.5 + frame, variance=0.25),
            }
            for topic, fields in messages.items():
                message = STORE.types[kinds[topic]](header=header(frame), **fields)
                writer.write(topics[topic], 1_000_000_000 * frame, STORE.serialize_cdr(message, kinds[topic]))


def by_rosbags(folder: Path) -> list[tuple]:
    with Reader(folder) as reader:
        return [(c.topic, c.msgtype, time, STORE.deserialize_cdr(data, c.msgtype)) for c, time, data in reader.messages()]


def by_mcap(folder: Path) -> list[tuple]:
    with open(next(folder.glob("*.mcap")), "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        return [
            (channel.topic, schema.name, schema.data, message.sequence, message.log_time, message.publish_time, bytes(message.data))
            for schema, channel, message in reader.iter_messages()
        ]


def pixels(topic: str, message) -> np.ndarray:
    if topic == "/image":
        return message.data.reshape(*SIZE, 3)[..., ::-1]
    return np.asarray(Image.open(io.BytesIO(message.data.tobytes())))


def read(before: Path, after: Path) -> None:
    before_raw, after_raw = by_mcap(before), by_mcap(after)
    assert len(before_raw) == len(after_raw) == 3 * FRAMES
    for a, b in zip(before_raw, after_raw):
        assert a[:-1] == b[:-1], (a[:-1], b[:-1])
        assert (a[-1] == b[-1]) == (a[0] == "/temperature"), a[0]
    shown = {}
    for (topic, kind, time, a), (*other, b) in zip(by_rosbags(before), by_rosbags(after)):
        assert [topic, kind, time] == other
        assert a.header == b.header
        if topic == "/temperature":
            assert a == b
            continue
        was, now = pixels(topic, a), pixels(topic, b)
        assert was.shape == now.shape and (was != now).any()
        shown.setdefault(time, []).append(now.astype(int))
    # Raw and compressed are the same image, up to its compression.
    assert all(np.abs(raw - packed).mean() < 12 for raw, packed in shown.values())
    print("same")


if __name__ == "__main__":
    {"write": write, "read": read}[sys.argv[1]](*map(Path, sys.argv[2:]))

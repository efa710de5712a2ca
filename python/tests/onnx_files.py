"""Small networks as ONNX, written field by field."""

from __future__ import annotations

import struct
from pathlib import Path


def mean_of_channels(path: Path, rows: int = 0, columns: int = 0, output: str = "depth") -> Path:
    """A network that gives the mean of the channels, 1 x 3 x height x width to 1 x height x width. A side of 0 is any."""
    axes = _number(1, 1) + _number(2, 7) + _field(8, b"channels") + _field(9, struct.pack("<q", 1))
    keep = _field(5, _field(1, b"keepdims") + _number(3, 0) + _number(20, 2))
    node = _field(1, b"image") + _field(1, b"channels") + _field(2, output.encode()) + _field(4, b"ReduceMean") + keep
    sides = b"".join(
        _field(1, _number(1, side) if side else _field(2, f"side {i}".encode()))
        for i, side in enumerate([1, 3, rows, columns])
    )
    image = _field(1, b"image") + _field(2, _field(1, _number(1, 1) + _field(2, sides)))
    graph = _field(1, node) + _field(2, b"depth") + _field(5, axes) + _field(11, image) + _field(12, _field(1, output.encode()))
    path.write_bytes(_number(1, 8) + _field(7, graph) + _field(8, _number(2, 18)))
    return path


def _field(number: int, data: bytes) -> bytes:
    return _varint(number << 3 | 2) + _varint(len(data)) + data


def _number(field: int, value: int) -> bytes:
    return _varint(field << 3) + _varint(value)


def _varint(value: int) -> bytes:
    data = bytearray()
    while value >= 128:
        data.append(value & 127 | 128)
        value >>= 7
    return bytes([*data, value])

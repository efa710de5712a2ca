"""Splats of ours read by other programs: gsply (.spz, .ply) and plyfile (.ply); and one compressed by gsply for us to read.

    readers.py FOLDER    FOLDER holds ours.ply and ours.spz; compressed.ply is written beside them

Prints a line for each: reader, file, and the largest difference of each property from ours.ply, as Markdown.
"""

import sys
from pathlib import Path

import gsply
import numpy as np
from plyfile import PlyData

# .spz has y up and z back, and gsply leaves its axes as they are.
FLIPPED = np.array([1.0, -1.0, -1.0])
HARMONICS = np.array([-1.0, -1.0, 1.0])


def properties(data, flipped=False):
    """Positions, scales, unit quaternions, opacities, colours, harmonics; in the axes of the PLY file."""
    sign, turn, harmonics = (FLIPPED, np.array([1.0, 1.0, -1.0, -1.0]), HARMONICS) if flipped else (1.0, 1.0, np.ones(3))
    quaternions = data.quats / np.linalg.norm(data.quats, axis=1, keepdims=True) * turn
    opacities = 1 / (1 + np.exp(-np.asarray(data.opacities, dtype=np.float64)))
    colours = 0.5 + 0.28209479 * data.sh0
    rest = data.shN.reshape(len(data.means), -1, 3) * harmonics[None, :, None]
    return data.means * sign, data.scales, quaternions, opacities, colours, rest


def differences(one, other):
    """The largest of each; of rotations, 1 - |q·p|."""
    result = []
    for number, (a, b) in enumerate(zip(one, other)):
        result.append(1 - np.abs((a * b).sum(1)).min() if number == 2 else np.abs(a - b).max())
    return " | ".join(f"{value:.4f}" for value in result)


def main():
    folder = Path(sys.argv[1])
    ours = gsply.plyread(str(folder / "ours.ply"))
    plain = properties(ours)
    print(f"| gsply | .spz | {differences(plain, properties(gsply.read_spz(str(folder / 'ours.spz')), flipped=True))} |")
    vertex = PlyData.read(str(folder / "ours.ply"))["vertex"]
    columns = lambda *names: np.stack([vertex[name] for name in names], axis=1)
    other = gsply.GSData.from_arrays(
        columns("x", "y", "z"),
        columns("scale_0", "scale_1", "scale_2"),
        columns("rot_0", "rot_1", "rot_2", "rot_3"),
        np.asarray(vertex["opacity"]),
        columns("f_dc_0", "f_dc_1", "f_dc_2"),
        np.stack([[vertex[f"f_rest_{3 * c + k}"] for c in range(3)] for k in range(3)]).transpose(2, 0, 1),
    )
    print(f"| plyfile | .ply | {differences(plain, properties(other))} |")
    gsply.plywrite(str(folder / "compressed.ply"), ours, compressed=True)


if __name__ == "__main__":
    main()

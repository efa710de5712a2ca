"""Writes NUMBER.flow for each frame NUMBER.png of a folder but the first: where each pixel was in the frame before.

Columns and rows, 32-bit floats, little endian, row by row; by OpenCV's DIS.
"""

import pathlib
import sys

import cv2

frames = sorted(pathlib.Path(sys.argv[1]).glob("*.png"))
dis = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
greys = [cv2.imread(str(frame), cv2.IMREAD_GRAYSCALE) for frame in frames]
for frame, before, after in zip(frames[1:], greys, greys[1:]):
    dis.calc(after, before, None).astype("<f4").tofile(frame.with_suffix(".flow"))

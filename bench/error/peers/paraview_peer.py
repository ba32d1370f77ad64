# SPDX-License-Identifier: Apache-2.0
"""ParaView as a peer of `goldthread bench error`, under mpirun:

    mpirun -n 2 pvbatch paraview_peer.py JOB FRAMES RESULT PICTURE

Renders the job's volume with ParaView's defaults for volumes, the job's camera and transfer function, FRAMES
times after a first one that prepares. Writes the times as JSON to RESULT and the picture as PNG.
"""
import json
import sys
import time

import paraview
from paraview.simple import (CreateView, GetColorTransferFunction, GetOpacityTransferFunction,
                             ImageReader, Render, SaveScreenshot, Show)

SCALAR_TYPES = {"uint8": "unsigned char", "int8": "char", "uint16": "unsigned short",
                "int16": "short", "float32": "float"}


def read_volume(volume):
    width, height, depth = volume["size"]
    return ImageReader(FileNames=[volume["file"]],
                       DataScalarType=SCALAR_TYPES[volume["type"]],
                       DataByteOrder="LittleEndian", FileDimensionality=3, FileLowerLeft=1,
                       DataExtent=[0, width - 1, 0, height - 1, 0, depth - 1],
                       DataSpacing=volume["spacing"], ScalarArrayName="value")


def look_from(job):
    view = CreateView("RenderView")
    view.ViewSize = job["imageSize"]
    view.UseColorPaletteForBackground = 0
    view.Background = job["background"]
    view.OrientationAxesVisibility = 0
    view.CameraPosition = job["camera"]["position"]
    view.CameraFocalPoint = job["camera"]["target"]
    view.CameraViewUp = job["camera"]["up"]
    view.CameraViewAngle = job["camera"]["fovy"]
    return view


def show_volume(job, view):
    shown = Show(read_volume(job["volume"]), view)
    color, opacity = GetColorTransferFunction("value"), GetOpacityTransferFunction("value")
    color.ColorSpace = "RGB"
    color.RGBPoints = [number for node in job["color"] for number in node]
    # A node of ParaView's is value, opacity, midpoint, sharpness.
    opacity.Points = [number for node in job["opacity"] for number in node + [0.5, 0]]
    shown.ColorArrayName = ["POINTS", "value"]
    shown.LookupTable = color
    shown.ScalarOpacityFunction = opacity
    shown.ScalarOpacityUnitDistance = job["unitDistance"]
    shown.SetRepresentationType("Volume")
    return shown


def frame_seconds(view):
    view.GetActiveCamera().Modified()
    start = time.perf_counter()
    Render(view)
    view.GetRenderWindow().WaitForCompletion()
    return time.perf_counter() - start


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        job = json.load(file)
    view = look_from(job)
    shown = show_volume(job, view)
    frame_seconds(view)
    seconds = [frame_seconds(view) for _ in range(int(sys.argv[2]))]
    SaveScreenshot(sys.argv[4], view, ImageResolution=job["imageSize"])
    with open(sys.argv[3], "w", encoding="utf-8") as file:
        json.dump({"version": paraview.__version__, "seconds": seconds,
                   "mapper": str(shown.VolumeRenderingMode).strip("'")}, file)


main()

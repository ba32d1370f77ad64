#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes data/vtk_colors.json: what VTK makes of each map in data/presets.json.

VTK (Debian: python3-vtk9) is the judge of the colour spaces and of opacity points; the unit test
compares with the file alone. Run it again after a change of presets.json.
"""
import json
import pathlib

from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkRenderingCore import vtkColorTransferFunction

SAMPLES = 97  # not a divisor of anything in the maps
DATA = pathlib.Path(__file__).parent / "data"


def color_function(preset):
    function = vtkColorTransferFunction()
    {
        "RGB": function.SetColorSpaceToRGB,
        "HSV": function.SetColorSpaceToHSV,
        "Lab": function.SetColorSpaceToLab,
        "CIELAB": function.SetColorSpaceToLab,
        "Diverging": function.SetColorSpaceToDiverging,
        "Step": function.SetColorSpaceToStep,
    }[preset.get("ColorSpace", "RGB")]()
    function.SetHSVWrap(bool(preset.get("HSVWrap", 0)))
    points = preset["RGBPoints"]
    for i in range(0, len(points), 4):
        function.AddRGBPoint(*points[i : i + 4])
    return function


def opacity_function(preset):
    function = vtkPiecewiseFunction()
    points = preset["Points"]
    for i in range(0, len(points), 4):
        function.AddPoint(*points[i : i + 4])
    return function


def main():
    expected = []
    for preset in json.loads((DATA / "presets.json").read_text()):
        low, high = preset["RGBPoints"][0], preset["RGBPoints"][-4]
        shares = [i / (SAMPLES - 1) for i in range(SAMPLES)]
        colors = color_function(preset)
        entry = {
            "name": preset["Name"],
            "shares": [round(s, 6) for s in shares],
            "colors": [[round(c, 5) for c in colors.GetColor(low + round(s, 6) * (high - low))] for s in shares],
        }
        if "Points" in preset:
            opacity = opacity_function(preset)
            entry["opacities"] = [round(opacity.GetValue(low + round(s, 6) * (high - low)), 6) for s in shares]
        expected.append(entry)
    lines = ",\n".join(json.dumps(entry, separators=(",", ":")) for entry in expected)
    (DATA / "vtk_colors.json").write_text("[\n" + lines + "\n]\n")


if __name__ == "__main__":
    main()

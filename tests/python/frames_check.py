"""Reads a frame file as a viewer does, with VTK's HDF reader and with h5py, and prints what each sees as JSON.

    frames_check.py FRAME.hdf

Arrays are printed in full: what they should hold is the caller's business.
"""

import json
import sys

import h5py
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader


def seen_by_vtk(path):
    reader = vtkHDFReader()
    assert reader.CanReadFile(path), "vtkHDFReader refuses the file"
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutputDataObject(0)
    data, fields = grid.GetPointData(), grid.GetFieldData()
    names = [data.GetArrayName(k) for k in range(data.GetNumberOfArrays())]
    return {
        "class": grid.GetClassName(),
        "points": grid.GetNumberOfPoints(),
        "cells": grid.GetNumberOfCells(),
        "cell_types": [grid.GetCellType(k) for k in range(grid.GetNumberOfCells())],
        "cell_points": [grid.GetCell(k).GetPointId(0) for k in range(grid.GetNumberOfCells())],
        "time": fields.GetArray("TimeValue").GetValue(0),
        "coordinates": vtk_to_numpy(grid.GetPoints().GetData()).tolist(),
        "data": {name: vtk_to_numpy(data.GetArray(name)).tolist() for name in sorted(names)},
    }


def seen_by_h5py(path):
    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        return {
            "version": root.attrs["Version"].tolist(),
            "type": root.attrs["Type"].decode("ascii"),
            "time": root["FieldData/TimeValue"][0],
            "coordinates": root["Points"][:].tolist(),
            "types": {name: str(dataset.dtype) for name, dataset in root["PointData"].items()},
            "data": {name: dataset[:].tolist() for name, dataset in root["PointData"].items()},
        }


if __name__ == "__main__":
    json.dump({"vtk": seen_by_vtk(sys.argv[1]), "h5py": seen_by_h5py(sys.argv[1])}, sys.stdout)

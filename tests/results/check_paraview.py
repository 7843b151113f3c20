"""Opens the sample run as ParaView does and compares every array with what was written.

Usage: check_paraview.py FOLDER (the one that the test "sample for ParaView" wrote). Exit code 77, which ctest
counts as skipped, when this machine has neither of ParaView's XDMF readers (Debian: python3-paraview).
"""

import os
import sys

try:
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOXdmf2 import vtkXdmfReader
    from vtkmodules.vtkIOXdmf3 import vtkXdmf3Reader
except ImportError as error:
    print("skipped:", error)
    sys.exit(77)


def blocks(data, found):
    """Leaves of a multiblock by name, without the index that the reader adds."""
    for k in range(data.GetNumberOfBlocks()):
        leaf = data.GetBlock(k)
        if leaf is None:
            continue
        if hasattr(leaf, "GetNumberOfBlocks"):
            blocks(leaf, found)
        else:
            found[data.GetMetaData(k).Get(vtkCompositeDataSet.NAME()).split("[")[0]] = leaf
    return found


def same(found, expected, what):
    found = vtk_to_numpy(found)
    assert found.shape == expected.shape and np.array_equal(found, expected), (what, found, expected)


def check_state(grids, k):
    grains, mesh = grids["grains"], grids["mesh"]
    assert grains.GetNumberOfPoints() == grains.GetNumberOfCells() == 3
    points = grains.GetPointData()
    same(points.GetArray("radius"), np.array([0.1, 0.2, 0.3]), "radius")
    same(points.GetArray("displacement"), 100.0 * k + np.arange(9.0).reshape(3, 3), "grains' displacement")
    same(points.GetArray("origin_id"), np.array([7, 8, 9]), "origin_id")

    assert mesh.GetNumberOfPoints() == 12 and mesh.GetNumberOfCells() == 2
    node = vtk_to_numpy(mesh.GetPointData().GetArray("node"))
    same(mesh.GetPointData().GetArray("displacement"), 1000.0 * k + np.arange(24.0).reshape(8, 3)[node], "nodes")
    voigt = 10000.0 * k + np.arange(12.0).reshape(2, 6)
    same(mesh.GetCellData().GetArray("stress"), voigt[:, [0, 1, 2, 5, 3, 4]], "stress")
    for cell in range(2):
        low, high = mesh.GetCell(cell).GetBounds()[:2]
        assert (low, high) == (cell, cell + 1), "a periodic element is drawn across the ground"


def main(folder):
    for reader_type in (vtkXdmfReader, vtkXdmf3Reader):
        reader = reader_type()
        reader.SetFileName(os.path.join(os.path.abspath(folder), "results.xdmf"))
        reader.UpdateInformation()
        information = reader.GetOutputInformation(0)
        key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
        times = [information.Get(key, k) for k in range(information.Length(key))]
        assert times == [0.0, 0.5, 1.0], times
        for k, time in enumerate(times):
            reader.UpdateTimeStep(time)
            check_state(blocks(reader.GetOutputDataObject(0), {}), k)
        print(reader_type.__name__, "reads every array of", len(times), "states")


main(sys.argv[1])

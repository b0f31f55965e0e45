#!/usr/bin/python3
"""Writes the malformed meshes of this folder and expected.tsv: file, line (0: the file as a whole), words of the message.

Each is a good mesh of one or two tets with one thing wrong.
"""
import base64
import pathlib
import struct

HERE = pathlib.Path(__file__).resolve().parent
expected = []


def case(name, content, line, words):
    data = content if isinstance(content, bytes) else content.encode()
    (HERE / name).write_bytes(data)
    expected.append((name, line, words))


# ---- Gmsh 2.2, text
MSH2 = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
$EndNodes
$Elements
1
1 4 2 7 1 1 2 3 4
$EndElements
"""


def msh2(name, old, new, line, words):
    assert old in MSH2, old
    case(name, MSH2.replace(old, new, 1), line, words)


case("empty.msh", "", 1, "the file is empty")
case("text_not_a_mesh.msh", "Dear reader,\nthis is no mesh.\n", 1, "expected '$MeshFormat'")
case("stl.msh", "solid cube\nfacet normal 0 0 1\n", 1, "expected '$MeshFormat'")
msh2("msh_version_1.msh", "2.2 0 8", "1.0 0 8", 2, "save the mesh as version 2.2 or 4.1")
msh2("msh_version_40.msh", "2.2 0 8", "4.0 0 8", 2, "save the mesh as version 2.2 or 4.1")
msh2("msh_file_type.msh", "2.2 0 8", "2.2 5 8", 2, "expected 0 to 1")
msh2("msh_data_size.msh", "2.2 0 8", "2.2 0 4", 2, "expected 8 to 8")
msh2("msh_no_end_format.msh", "$EndMeshFormat\n", "", 3, "expected '$EndMeshFormat'")
msh2("msh_negative_nodes.msh", "$Nodes\n4", "$Nodes\n-4", 5, "expected at least 0")
msh2("msh_huge_nodes.msh", "$Nodes\n4", "$Nodes\n9000000000000000000", 5, "bytes of the file are left")
msh2("msh_overflowing_nodes.msh", "$Nodes\n4", "$Nodes\n99999999999999999999999", 5, "a whole number")
msh2("msh_too_many_nodes.msh", "$Nodes\n4", "$Nodes\n9", 10, "expected a node number")
msh2("msh_too_few_nodes.msh", "$Nodes\n4", "$Nodes\n3", 9, "expected '$EndNodes'")
msh2("msh_nan.msh", "3 0 1 0", "3 0 nan 0", 8, "expected a coordinate (a finite number)")
msh2("msh_infinite.msh", "3 0 1 0", "3 0 -inf 0", 8, "expected a coordinate (a finite number)")
msh2("msh_overflowing_real.msh", "3 0 1 0", "3 0 1e999 0", 8, "expected a coordinate (a finite number)")
msh2("msh_comma_decimal.msh", "3 0 1 0", "3 0 1,5 0", 8, "found '1,5'")
msh2("msh_letter_in_number.msh", "3 0 1 0", "3 0 1x 0", 8, "found '1x'")
msh2("msh_node_twice.msh", "4 0 0 1\n", "3 0 0 1\n", 9, "node 3 is defined twice")
msh2("msh_unknown_node.msh", "1 2 3 4\n", "1 2 3 5\n", 13, "uses node 5, which is not in '$Nodes'")
msh2("msh_unknown_type.msh", "1 4 2 7", "1 77 2 7", 13, "element type 77 is not known")
msh2("msh_second_order.msh", "1 4 2 7", "1 11 2 7", 13, "save the mesh with order 1")
msh2("msh_prism.msh", "1 4 2 7 1 1 2 3 4", "1 6 2 7 1 1 2 3 4 1 2", 13, "expected tetrahedra only")
msh2("msh_negative_tags.msh", "1 4 2 7", "1 4 -2 7", 13, "expected 0 to 64")
msh2("msh_many_tags.msh", "1 4 2 7", "1 4 2000000000 7", 13, "expected 0 to 64")
msh2("msh_huge_elements.msh", "$Elements\n1", "$Elements\n4000000000", 12, "bytes of the file are left")
msh2("msh_no_elements.msh", MSH2[MSH2.index("$Elements"):], "", 11, "without a section '$Elements'")
msh2("msh_no_nodes.msh", MSH2[MSH2.index("$Nodes"):MSH2.index("$Elements")], "", 5, "'$Elements' comes before '$Nodes'")
msh2("msh_nodes_first.msh", MSH2[:MSH2.index("$Nodes")], "$Comments\nno format\n$EndComments\n", 4, "'$Nodes' comes before '$MeshFormat'")
msh2("msh_no_tets.msh", "1 4 2 7 1 1 2 3 4", "1 2 2 7 1 1 2 3", 0, "has no tetrahedra")
msh2("msh_truncated.msh", " 3 4\n$EndElements\n", "", 13, "the file ends where a node number was expected")
msh2("msh_unclosed_section.msh", "$EndElements\n", "$EndElements\n$Periodic\n1\n", 15, "has no end")
msh2("msh_name_not_quoted.msh", "$Nodes", "$PhysicalNames\n1\n3 7 fat\n$EndPhysicalNames\n$Nodes", 7, "in double quotes")
msh2("msh_flat_tet.msh", "4 0 0 1\n", "4 1 1 0\n", 0, "tetrahedron 0 has no volume")
msh2("msh_node_repeated_in_tet.msh", "1 2 3 4\n", "1 2 3 3\n", 0, "names node 2 twice")
msh2("msh_all_nodes_equal.msh", "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1", "1 2 2 2\n2 2 2 2\n3 2 2 2\n4 2 2 2", 0, "has no volume")
overlap = MSH2.replace("$Nodes\n4", "$Nodes\n5").replace("4 0 0 1\n", "4 0 0 1\n5 .2 .2 .5\n")
case("msh_inside_out.msh", overlap.replace("$Elements\n1", "$Elements\n2").replace("1 2 3 4\n", "1 2 3 4\n2 4 2 7 1 1 2 3 5\n"),
     0, "one of them is inside out")
case("msh_three_at_a_face.msh", overlap.replace("$Elements\n1", "$Elements\n3").replace(
    "1 2 3 4\n", "1 2 3 4\n2 4 2 7 1 1 2 3 5\n3 4 2 7 1 2 1 3 5\n"), 0, "share one face")


# ---- Gmsh 2.2, binary
def msh2_binary(order="<", nodes=4, block=1, corner=4, x=1.0, mark=1, tags=2, cut=None):
    out = b"$MeshFormat\n2.2 1 8\n" + struct.pack(order + "i", mark) + b"\n$EndMeshFormat\n$Nodes\n%d\n" % nodes
    for i, p in enumerate([(0, 0, 0), (x, 0, 0), (0, 1, 0), (0, 0, 1)]):
        out += struct.pack(order + "iddd", i + 1, *p)
    out += b"\n$EndNodes\n$Elements\n1\n" + struct.pack(order + "iii", 4, block, tags)
    out += struct.pack(order + "i2i4i", 1, 7, 1, 1, 2, 3, corner) + b"\n$EndElements\n"
    return out[:cut]


case("msh_binary_mark.msh", msh2_binary(mark=2), 3, "endianness mark")
case("msh_binary_mixed_endian.msh", msh2_binary(order=">").replace(struct.pack(">i", 1) + b"\n$End", struct.pack("<i", 1) + b"\n$End", 1),
     11, "a block of 16777216 elements")
case("msh_binary_huge_nodes.msh", msh2_binary(nodes=2000000000), 6, "bytes of the file are left")
case("msh_binary_nan.msh", msh2_binary(x=float("nan")), 7, "a coordinate is not a finite number")
case("msh_binary_block.msh", msh2_binary(block=-1), 11, "a block of -1 elements")
case("msh_binary_tags.msh", msh2_binary(tags=1 << 30), 11, "a number of tags is")
case("msh_binary_unknown_node.msh", msh2_binary(corner=-4), 11, "uses node -4")
case("msh_binary_truncated.msh", msh2_binary(cut=150), 6, "bytes of the file are left")
case("msh_binary_truncated_late.msh", msh2_binary(cut=-20), 11, "the file ends where a node number was expected")

# ---- Gmsh 4.1, text
MSH4 = """$MeshFormat
4.1 0 8
$EndMeshFormat
$Entities
0 0 0 1
1 0 0 0 1 1 1 1 7 0
$EndEntities
$Nodes
1 4 1 4
3 1 0 4
1
2
3
4
0 0 0
1 0 0
0 1 0
0 0 1
$EndNodes
$Elements
1 1 1 1
3 1 4 1
1 1 2 3 4
$EndElements
"""


def msh4(name, old, new, line, words):
    assert old in MSH4, old
    case(name, MSH4.replace(old, new, 1), line, words)


msh4("msh4_huge_entities.msh", "0 0 0 1\n", "0 0 0 88888888\n", 5, "bytes of the file are left")
msh4("msh4_negative_entities.msh", "0 0 0 1\n", "0 0 0 -1\n", 5, "expected at least 0")
msh4("msh4_huge_physicals.msh", "1 7 0\n", "99999999 7 0\n", 6, "bytes of the file are left")
msh4("msh4_huge_blocks.msh", "1 4 1 4", "1000000 4 1 4", 9, "bytes of the file are left")
msh4("msh4_block_too_long.msh", "3 1 0 4", "3 1 0 5", 10, "more than the 4 nodes announced")
msh4("msh4_dimension.msh", "3 1 0 4", "7 1 0 4", 10, "expected 0 to 3")
msh4("msh4_elements_missing.msh", "1 1 1 1\n3 1 4 1", "1 2 1 2\n3 1 4 1", 23, "hold 1 elements, expected 2")
msh4("msh4_unknown_node.msh", "1 1 2 3 4\n", "1 1 2 3 40\n", 23, "uses node 40")

# ---- VTK legacy
VTK = """# vtk DataFile Version 3.0
one tet
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 double
0 0 0
1 0 0
0 1 0
0 0 1
CELLS 1 5
4 0 1 2 3
CELL_TYPES 1
10
CELL_DATA 1
SCALARS region int 1
LOOKUP_TABLE default
7
"""


def vtk(name, old, new, line, words):
    assert old in VTK, old
    case(name, VTK.replace(old, new, 1), line, words)


vtk("vtk_version.vtk", "Version 3.0", "Version 9.0", 2, "versions 2 to 5")
vtk("vtk_no_version.vtk", " Version 3.0", "", 2, "expected '# vtk DataFile Version n.n'")
vtk("vtk_form.vtk", "ASCII", "ascii", 3, "expected ASCII or BINARY")
vtk("vtk_polydata.vtk", "UNSTRUCTURED_GRID", "POLYDATA", 4, "expected UNSTRUCTURED_GRID")
vtk("vtk_huge_points.vtk", "POINTS 4", "POINTS 4000000000", 5, "bytes of the file are left")
vtk("vtk_integer_points.vtk", "4 double", "4 int", 5, "expected float or double")
vtk("vtk_nan.vtk", "0 1 0", "0 NaN 0", 8, "expected a coordinate (a finite number)")
vtk("vtk_index_high.vtk", "4 0 1 2 3", "4 0 1 2 4", 10, "uses point 4, expected 0 to 3")
vtk("vtk_index_negative.vtk", "4 0 1 2 3", "4 0 1 2 -1", 10, "uses point -1, expected 0 to 3")
vtk("vtk_cell_too_long.vtk", "4 0 1 2 3", "40 0 1 2 3", 11, "more than the size of the cell list leaves")
vtk("vtk_cell_negative.vtk", "4 0 1 2 3", "-4 0 1 2 3", 11, "cell 0 has -4 points")
vtk("vtk_three_point_tet.vtk", "CELLS 1 5\n4 0 1 2 3", "CELLS 1 4\n3 0 1 2", 10, "a tetrahedron with 3 points")
vtk("vtk_types_missing.vtk", "CELL_TYPES 1\n10\n", "", 16, "without CELL_TYPES")
vtk("vtk_types_count.vtk", "CELL_TYPES 1", "CELL_TYPES 2", 12, "2 cell types for 1 cells")
vtk("vtk_pyramid.vtk", "\n10\n", "\n14\n", 10, "is of type 14, no tetrahedron")
vtk("vtk_quadratic.vtk", "\n10\n", "\n24\n", 10, "second-order tetrahedron")
vtk("vtk_region_count.vtk", "CELL_DATA 1", "CELL_DATA 3", 14, "3 values for 1 cells")
vtk("vtk_region_fraction.vtk", "SCALARS region int 1\nLOOKUP_TABLE default\n7", "SCALARS region double 1\nLOOKUP_TABLE default\n7.5", 10,
    "the region of cell 0 is not a whole number")
vtk("vtk_unknown_type.vtk", "region int 1", "region complex 1", 15, "data type 'complex' is not known")
vtk("vtk_unknown_keyword.vtk", "SCALARS region int 1", "RAINBOW region int 1", 15, "found 'RAINBOW'")
vtk("vtk_truncated.vtk", "CELL_TYPES 1\n10\nCELL_DATA 1\nSCALARS region int 1\nLOOKUP_TABLE default\n7\n", "CELL_TYPES 1\n", 13, "the file ends where a cell type was expected")
case("vtk_little_endian.vtk", VTK[:VTK.index("0 0 0")].replace("ASCII", "BINARY").encode() + struct.pack("<12d", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
     + b"\nCELLS 1 5\n" + struct.pack("<5i", 4, 0, 1, 2, 3) + b"\nCELL_TYPES 1\n" + struct.pack("<i", 10), 8, "more than the size of the cell list leaves")


# ---- VTU
def block(form, *values):
    data = struct.pack("<%d%s" % (len(values), form), *values)
    return base64.b64encode(struct.pack("<I", len(data)) + data).decode()


VTU = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="1">
<Points>
<DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0
1 0 0
0 1 0
0 0 1
</DataArray>
</Points>
<Cells>
<DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="binary">%s</DataArray>
</Cells>
</Piece>
</UnstructuredGrid>
</VTKFile>
""" % block("B", 10)


def vtu(name, old, new, line, words):
    assert old in VTU, old
    case(name, VTU.replace(old, new, 1), line, words)


vtu("vtu_not_xml.vtu", "</Points>", "</Pints>", 5, "not well-formed XML")
vtu("vtu_polydata.vtu", 'type="UnstructuredGrid"', 'type="PolyData"', 2, 'expected type="UnstructuredGrid"')
vtu("vtu_root.vtu", VTU, "<mesh/>", 1, "expected the element <VTKFile>")
vtu("vtu_compressed.vtu", 'byte_order="LittleEndian"', 'byte_order="LittleEndian" compressor="vtkLZ4DataCompressor"', 2,
    "expected vtkZLibDataCompressor")
vtu("vtu_no_piece.vtu", VTU[VTU.index("<Piece"):VTU.index("</UnstructuredGrid>")], "", 3, "has no element <Piece>")
vtu("vtu_two_pieces.vtu", "</Piece>", '</Piece><Piece NumberOfPoints="0" NumberOfCells="0"/>', 18, "more than one <Piece>")
vtu("vtu_negative_points.vtu", 'NumberOfPoints="4"', 'NumberOfPoints="-4"', 4, "expected a count")
vtu("vtu_huge_points.vtu", 'NumberOfPoints="4"', 'NumberOfPoints="2000000000"', 6, "does not hold the 6000000000 values")
vtu("vtu_absurd_points.vtu", 'NumberOfPoints="4"', 'NumberOfPoints="18446744073709551615"', 4, "more than any mesh file can hold")
vtu("vtu_two_components.vtu", 'NumberOfComponents="3"', 'NumberOfComponents="2"', 6, "NumberOfComponents")
vtu("vtu_nan.vtu", "0 1 0\n", "0 nan 0\n", 9, "expected a value (a finite number)")
vtu("vtu_index.vtu", "0 1 2 3</", "0 1 2 9</", 13, "uses point 9, expected 0 to 3")
vtu("vtu_offset.vtu", ">4</", ">-4</", 15, "do not ascend")
vtu("vtu_huge_offset.vtu", ">4</", ">2000000000</", 14, "does not hold the 2000000000 values")
vtu("vtu_float_index.vtu", 'type="Int32" Name="connectivity"', 'type="Float32" Name="connectivity"', 14, "where whole numbers were expected")
vtu("vtu_no_types.vtu", 'Name="types"', 'Name="kinds"', 13, "needs the arrays connectivity, offsets and types")
vtu("vtu_base64.vtu", block("B", 10), "AQAAAA!!", 16, "not base64")
vtu("vtu_block_size.vtu", block("B", 10), block("B", 10, 10), 16, "has 2 bytes, expected 1")
vtu("vtu_big_endian_claimed.vtu", "LittleEndian", "BigEndian", 16, "is header_type or byte_order wrong?")
vtu("vtu_block_short.vtu", block("B", 10), "AQ==", 16, "expected 1")
vtu("vtu_appended_offset.vtu", 'format="binary">%s</DataArray>' % block("B", 10), 'format="appended" offset="999"/>', 16, "behind the end of <AppendedData>")
vtu("vtu_format.vtu", 'format="binary"', 'format="hex"', 16, "expected ascii, binary or appended")
case("vtu_appended_no_mark.vtu", VTU.replace("</VTKFile>", "<AppendedData encoding=\"raw\">"), 0, "without its '_' mark")

(HERE / "expected.tsv").write_text("".join(f"{n}\t{l}\t{w}\n" for n, l, w in expected))
print(len(expected), "malformed meshes")

// A block of 20 x 10 x 10 mm, base at z = 0: the tissue of the small scenes, one per component.
Point(1) = {-10, -5, 0};
Point(2) = { 10, -5, 0};
Point(3) = { 10,  5, 0};
Point(4) = {-10,  5, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
out[] = Extrude {0, 0, 10} { Surface{1}; };
Physical Volume("flesh", 1) = {out[1]};
Mesh.MeshSizeMin = 3.5; Mesh.MeshSizeMax = 3.5;

// Two boxes of 2 x 1 x 1, one on top of the other: the mesh of the reader tests.
Point(1) = {0, 0, 0}; Point(2) = {2, 0, 0}; Point(3) = {2, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
lower[] = Extrude {0, 0, 1} { Surface{1}; };
upper[] = Extrude {0, 0, 1} { Surface{lower[0]}; };
Physical Volume("fat", 7) = {lower[1]};
Physical Volume("dermis", 12) = {upper[1]};
Mesh.MeshSizeMin = 1.2; Mesh.MeshSizeMax = 1.2;

// A pad of two layers, in millimetres: 50 x 30 x 10, top at z = 0, dermis 3 mm thick over fat.
// Finer where a 26 mm half-circle needle (radius 8.28) passes from x = -8 to x = +8 at y = 0.
length = 50; width = 30; dermis = 3; fat = 7;
fine = 1.25; coarse = 4.5;

Point(1) = {-length/2, -width/2, 0};
Point(2) = { length/2, -width/2, 0};
Point(3) = { length/2,  width/2, 0};
Point(4) = {-length/2,  width/2, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
upper[] = Extrude {0, 0, -dermis} { Surface{1}; };    // [0]: the interface, [1]: the volume
lower[] = Extrude {0, 0, -fat} { Surface{upper[0]}; };

Physical Volume("dermis", 1) = {upper[1]};
Physical Volume("fat", 2) = {lower[1]};

Field[1] = Box;
Field[1].XMin = -11; Field[1].XMax = 11;
Field[1].YMin = -3;  Field[1].YMax = 3;
Field[1].ZMin = -8;  Field[1].ZMax = 0;
Field[1].VIn = fine; Field[1].VOut = coarse; Field[1].Thickness = 12;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
Mesh.OptimizeThreshold = 0.4;

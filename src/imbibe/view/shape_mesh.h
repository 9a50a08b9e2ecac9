// Solids as triangles to draw: boxes, spheres, cylinders and cones with smooth normals where they are smooth, closed
// meshes as they are. A plane has no triangles here: the picture's ground stands for it.
#pragma once

#include "imbibe/view/frame.h"

namespace imbibe {

DrawnMesh mesh_of(const Shape& shape);

}  // namespace imbibe

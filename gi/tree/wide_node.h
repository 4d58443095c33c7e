// A node of a SurfelTree, for C++ and OpenCL C.
#ifndef LUCARNE_GI_TREE_WIDE_NODE_H
#define LUCARNE_GI_TREE_WIDE_NODE_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_CONST int kLeafChild = -1;  // the child is one surfel
LUCARNE_CONST int kNoChild = -2;
LUCARNE_CONST float kCloud = -1.0f;

// Eight children, each property in a row of its own, so that one vector load reads it for all of them. A
// "slot" is 8 * node + place of the child.
//
// Where a child is small it is drawn as a piece of the plane through its middle: what lies in the sphere and
// in the box about it. A surfel is its disc. A node of one surface is cut by its box, the bounds of its
// discs, so that nodes of one wall overlap and its ends are not beyond those of its discs. A cloud, a node of
// several directions, has no plane: its disc faces whoever looks. Clouds, and surfaces with holes, are drawn
// with the probability `fill`.
LUCARNE_STRUCT(WideNode) {
    float x[8], y[8], z[8];     // middle of the child, m
    float bound[8];             // radius of the sphere about the middle that holds all discs of the child, m
    float nx[8], ny[8], nz[8];  // unit axis: a surfel's normal, or the direction that most normals share
    float thickness[8];         // no disc is farther from the plane through the middle, m
    // The box, from the middle, m. Of a cloud low_x is its probability, and high_x is kCloud. Of a surfel low
    // is the line at which its disc ends (gi/shared/edge.h), 1/m.
    float low_x[8], low_y[8], low_z[8], high_x[8], high_y[8], high_z[8];
    // Bit 8 j + i is the part i along the axis after that along which the node's own axis is longest (after z
    // comes x), and j along the next.
    uint mask_low[8], mask_high[8];
    int child[8];  // number of a node, or one of the constants above
};

#ifdef __cplusplus
static_assert(sizeof(WideNode) == 544);
}  // namespace lucarne::gi
#endif
#endif

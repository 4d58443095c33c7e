// A node of a SurfelTree, for C++ and OpenCL C.
#ifndef LUCARNE_GI_TREE_WIDE_NODE_H
#define LUCARNE_GI_TREE_WIDE_NODE_H

#include "gi/shared/language.h"

#ifdef __cplusplus
namespace lucarne::gi {
#endif

LUCARNE_CONST int kLeafChild = -1;  // the child is one surfel
LUCARNE_CONST int kNoChild = -2;

// Eight children, each property in a row of its own, so that one vector load reads it for all of them. A
// "slot" is 8 * node + place of the child.
LUCARNE_STRUCT(WideNode) {
    float x[8], y[8], z[8];     // middle of the child, m
    float bound[8];             // radius of the sphere about the middle that holds all discs of the child, m
    float nx[8], ny[8], nz[8];  // unit axis: a surfel's normal, or the direction that most normals share
    float disc[8];              // radius of the disc that stands for the child where it is small, m
    float thickness[8];         // no disc is farther from the plane through the middle, m
    int child[8];               // number of a node, or one of the constants above
};

#ifdef __cplusplus
static_assert(sizeof(WideNode) == 320);
}  // namespace lucarne::gi
#endif
#endif

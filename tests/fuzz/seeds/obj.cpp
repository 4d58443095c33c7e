// Makes OBJ: polygons with everything that may stand at a corner, and materials in the file itself.
#include "tests/fuzz/seeds/seeds.h"

namespace lucarne::fuzz {

void obj_seeds(const Seeds& seeds) {
    seeds.add_scan(
        "polygons",
        "v 0 0 0 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n"
        "usemtl a\no b\nf 1/1/1 2/2/1 3/3/1\nf -6 -5 -4 \\\n -3 -2 -1\nl 1 2\nf 1//1 3//1 4//1\n");
    for (const char* descriptor : {"3", "4", "5", "6"})
        seeds.add_scan(std::string("materials-") + descriptor,
                       std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nmtllib ") + descriptor +
                           "\nnewmtl a b\nKd 1 .5 0\nmap_Kd -s 2 2 -o .5 -clamp on x.png\nusemtl a b\n"
                           "f 1/1 2/1 3/1\n");
    seeds.add_scan("further-down",
                   "v 0 0 0\nf 1/1/1 2/2/1 3/-9/0 4\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\n");
    seeds.add_scan("vertices", "v 0 0 0 255 0 0\nv 1 0 0\nv 1e6 1e5 -3\n");
}

}  // namespace lucarne::fuzz

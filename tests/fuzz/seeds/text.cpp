// Makes XYZ, CSV, PTS and PTX.
#include "tests/fuzz/seeds/seeds.h"

namespace lucarne::fuzz {
namespace {

constexpr const char* kTransform = "1 0 0 0\n0 1 0 0\n0 0 1 0\n";

/// Returns one scan of two columns and two rows with the given points.
std::string ptx(const std::string& place, const std::string& points) {
    return "2\n2\n" + place + "\n1 0 0\n0 1 0\n0 0 1\n" + kTransform + place + " 1\n" + points;
}

}  // namespace

void text_seeds(const Seeds& seeds) {
    seeds.add_scan("plain.xyz", "1 2 3\n4.5 -5e-1 +6\n7 8 9\n");
    seeds.add_scan("named.csv",
                   "x,y,z,intensity,r,g,b,class\n1,2,3,10,255,0,0,2\n4,5,6,,0,255,0,3\n7,8,9,12,0,0,255,6\n");
    seeds.add_scan("empty.csv", "x,y,z,a,b,c,d\n1,2,3,4,5,6,7\n1,2,3,,,,\n,,,,,,\n4,5,6,,,,\n7,8,9,,,,\n");
    seeds.add_scan("commented.txt",
                   "//X Y Z Nx Ny Nz\n500000.125\t4000000.5\t12.25\t0\t0\t1\n500001\t4000001\t12\t0\t1\t0\n");
    seeds.add_scan("semicolons.asc", "1;2;3;a word;0.5\n4;5;6;another;0.25\n\n7;8;nan;third;1\n");
    seeds.add_scan("guessed.xyz",
                   "0 0 0 10 20 30 0.6 0.8 0\r\n1 1 1 200 100 50 0 0 1\r\n2 2 2 255 255 255 1 0 0\r\n");
    seeds.add_scan("one.pts", "2\n1 2 3 -1035 97 59 38\n4 5 6 2047 1 2 3\n");
    seeds.add_scan("marked.ptx", "\xef\xbb\xbf" + ptx("0 0 0", "1 2 3 0.5\n0 0 0 0\n4 5 6 1\n7 8 9 0\n"));
    seeds.add_scan(
        "marked.pcd",
        "\xef\xbb\xbf# by hand\nVERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\n"
        "DATA ascii\n1 2 3\n");
    seeds.add_scan("marked.obj", "\xef\xbb\xbf# by hand\nv 0 0 0\nv 1 0 0\n");
    seeds.add_scan("several.pts", "1\n1 2 3 0.5\n2\n4 5 6 0.25\n7 8 9 1\n");
    seeds.add_scan("colored.ptx",
                   ptx("0.5 1 2", "1 2 3 0.5 10 20 30\n0 0 0 0.5 0 0 0\n4 5 6 1 1 2 3\n7 8 9 0 4 5 6\n"));
    seeds.add_scan("two.ptx", ptx("0 0 0", "1 2 3 0.5\n0 0 0 0\n4 5 6 1\n7 8 9 0\n") +
                                  ptx("1000 2000 3", "1 2 3 0.5\n0 0 0 0.5\n4 5 6 1\n7 8 9 0\n"));
}

}  // namespace lucarne::fuzz

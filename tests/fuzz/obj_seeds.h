#pragma once
// OBJ and MTL files that mutations begin with.

namespace rayfarm {

inline constexpr const char* kObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvt 1 1\nusemtl a\ns 1\n"
    "f 1/1/1 2/2/1 3/1/1 4/2/1\nf -1 -2 -3\nf 1 2 3 4 2\ng x\no y\nf 1//1 2//1 3//1\n";
inline constexpr const char* kMtl =
    "newmtl a\nKd 1 .5 0\nKs .2 .2 .2\nNs 20\nillum 3\nd 0.5\nNi 1.5\nmap_Kd -o 0.1 0 -s 2 2 t.png\nKe 0 0 "
    "0\n";
inline constexpr const char* kSmoothObj =
    "mtllib a.mtl\nv 0 0 0 1 .5 0\nv 1 0 \\\n0\nv 1 1 0 255 0 1\nv 0 1 3.1+e0\ns 1\nf 1// 2/ 3\ns 2\nf 1 3 4 "
    "# end\n"
    "s off\nusemtl a\nfo +1 3 2\n";
inline constexpr const char* kPhysicalMtl =
    "newmtl a\nKd 1 .5 0\nPr .3\nPm 1\nPc .5\nPcr .1\nKs .5 .5 .5\nmap_Pr -imfchan g -clamp on t.png\nmap_Pm "
    "t.png\n"
    "norm -bm .5 t.png\nmap_Ke t.png\n";
inline constexpr const char* kGlassMtl =
    "newmtl a\nKd 0 0 0\nKs 1 1 1\nillum 7\nTr .9\nTf 1 .5 1\nmap_Bump t.png -bm 2\nmap_Ks t.png\nnewmtl "
    "b\nKd 1 1 1\n"
    "Ns 90\nd .5\nmap_d t.png\n";
inline constexpr const char* kYamlMesh =
    "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene: [{mesh: {file: a.obj, smooth: phong}}]\n";

}  // namespace rayfarm

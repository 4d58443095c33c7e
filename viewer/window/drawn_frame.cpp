#include "viewer/window/drawn_frame.h"

#include <cstddef>

#include <imgui.h>
#include <xxhash.h>

namespace lucarne::viewer {
namespace {

template <class T>
uint64_t add(uint64_t before, const ImVector<T>& values) {
    return XXH3_64bits_withSeed(values.Data, static_cast<size_t>(values.size_in_bytes()), before);
}

}  // namespace

uint64_t fingerprint(const ImDrawData& data) {
    uint64_t sum = static_cast<uint64_t>(data.CmdListsCount);
    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        sum = add(add(sum, list.VtxBuffer), list.IdxBuffer);
        for (const ImDrawCmd& command : list.CmdBuffer) {  // member by member, because the struct has padding
            const float* clip = &command.ClipRect.x;
            sum = XXH3_64bits_withSeed(clip, 4 * sizeof(float), sum);
            const uint64_t rest[] = {reinterpret_cast<uint64_t>(command.TextureId), command.VtxOffset,
                                     command.IdxOffset, command.ElemCount,
                                     reinterpret_cast<uint64_t>(command.UserCallback)};
            sum = XXH3_64bits_withSeed(rest, sizeof rest, sum);
        }
    }
    return sum;
}

}  // namespace lucarne::viewer

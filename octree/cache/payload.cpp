#include "octree/cache/payload.h"

#include <utility>

#include <fmt/format.h>

#include "octree/cache/checked_read.h"

namespace lucarne::octree {

Result<NodeData> load_payload(const ByteSource& file, uint32_t node, const NodeInfo& info,
                              const StoredPayload& payload, codec::DecoderPool& decoders, uint32_t stride) {
    const bool raw = payload.codec == format::kCodecRaw;
    LUCARNE_ASSIGN(auto bytes,
                   read_checked(file, payload.offset, info.payload_bytes, payload.checksum,
                                node == kNoNode ? "its synthetic surfels" : fmt::format("node {}", node),
                                raw ? 0 : codec::kReadAhead));
    if (raw) return NodeData{info.count, std::move(bytes)};
    NodeData data{info.count, std::vector<std::byte>(size_t{info.count} * stride)};
    if (!decoders.decode(std::span(bytes).first(info.payload_bytes), data.records))
        return damaged(file, node == kNoNode ? "its synthetic surfels do not decode"
                                             : fmt::format("the points of node {} do not decode", node));
    return data;
}

Result<PayloadReader> PayloadReader::create(const std::string& name, const SourceHeader& header) {
    PayloadReader reader;
    reader.layouts_.push_back(
        {header.schema.stride, std::make_unique<codec::DecoderPool>(header.schema), {}});
    for (const auto& layout : header.layouts) {
        if (!RecordMap::fits(layout, header.schema))
            return rejected(name, "it has a layout that does not fit into its schema", kConvertAgain);
        reader.layouts_.push_back(
            {layout.stride, std::make_unique<codec::DecoderPool>(layout), RecordMap(layout, header.schema)});
    }
    return reader;
}

Result<NodeData> PayloadReader::load(const ByteSource& file, uint32_t node, const NodeInfo& info,
                                     const StoredPayload& payload) const {
    const Layout& layout = layouts_[payload.layout];
    LUCARNE_ASSIGN(NodeData data, load_payload(file, node, info, payload, *layout.decoders, layout.stride));
    if (!layout.to_schema) return data;
    NodeData converted{data.count, {}};
    layout.to_schema->convert(data.records.data(), data.count, converted.records);
    return converted;
}

}  // namespace lucarne::octree

#include "octree/build/build_inputs.h"

namespace lucarne::octree {

Result<std::optional<bool>> wanted_normals(NormalsMode mode, const Unifier& inputs) {
    size_t without = inputs.inputs();
    for (size_t i = inputs.inputs(); i-- > 0;)
        if (!inputs.has_normals(i)) without = i;
    const bool all = without == inputs.inputs();
    switch (mode) {
        case NormalsMode::none:
            return std::optional<bool>();
        case NormalsMode::automatic:
            return std::optional(!all);
        case NormalsMode::estimate:
            return std::optional(true);
        case NormalsMode::keep:
            break;
    }
    if (!all)
        return bad_arguments(inputs.source(without).info().path, "has no normals to keep",
                             "use --normals estimate");
    return std::optional(false);
}

Result<void> check_units(const Unifier& inputs) {
    for (size_t i = 1; i < inputs.inputs(); ++i)
        if (inputs.source(i).info().metres_per_unit != inputs.source(0).info().metres_per_unit)
            return rejected(inputs.source(i).info().path, "is in another unit than the first input",
                            "convert it on its own");
    return {};
}

SourceHeader header_of(const Unifier& inputs, const ScanFacts& facts, const io::Schema& schema) {
    SourceHeader header{
        .schema = schema, .root = facts.root, .min = facts.min, .max = facts.max, .points = facts.points};
    header.metres_per_unit = inputs.source(0).info().metres_per_unit;
    for (size_t i = 0; i < inputs.inputs(); ++i) {
        header.scans.push_back(inputs.source(i).info());
        if (i < facts.inputs.size()) header.scans.back().losses = facts.inputs[i].losses;
    }
    return header;
}

}  // namespace lucarne::octree

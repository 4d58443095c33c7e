// The LAS header as JSON and back: see las_header.h.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/formats/las/base64.h"
#include "io/formats/common/format.h"
#include "io/formats/las/header.h"

namespace lucarne::io::las {

nlohmann::json records_to_json(const std::vector<Vlr>& vlrs) {
    nlohmann::json records = nlohmann::json::array();
    for (const Vlr& vlr : vlrs)
        records.push_back({{"user_id", vlr.user_id},
                           {"record_id", vlr.record_id},
                           {"description", vlr.description},
                           {"extended", vlr.extended},
                           {"data", to_base64(vlr.data)}});
    return records;
}

std::optional<std::vector<Vlr>> records_from_json(const nlohmann::json& records) try {
    std::vector<Vlr> vlrs;
    for (const auto& record : records) {
        auto data = from_base64(record.at("data").get<std::string>());
        const auto id = record.at("record_id").get<uint64_t>();
        if (!data || id > 0xffff) return std::nullopt;
        vlrs.push_back({record.at("user_id").get<std::string>(), static_cast<uint16_t>(id),
                        record.at("description").get<std::string>(), record.at("extended").get<bool>(),
                        std::move(*data)});
    }
    return vlrs;
} catch (const nlohmann::json::exception&) {
    return std::nullopt;
}

nlohmann::json to_details(const Header& h) {
    return {{"format", "las"},
            {"minor_version", h.minor},
            {"point_format", h.point_format},
            {"record_length", h.record_length},
            {"file_source_id", h.file_source_id},
            {"global_encoding", h.global_encoding},
            {"guid", to_base64(std::as_bytes(std::span(h.guid)))},
            {"system_id", h.system_id},
            {"software", h.software},
            {"creation_day", h.creation_day},
            {"creation_year", h.creation_year},
            {"scale", {h.scale.x, h.scale.y, h.scale.z}},
            {"offset", {h.offset.x, h.offset.y, h.offset.z}},
            {"records", records_to_json(h.vlrs)}};
}

Result<Header> from_details(const std::string& file, const nlohmann::json& details) try {
    Header h;
    // Narrow on purpose: a number that does not fit was not written by to_details.
    const auto number = [&](const char* key, uint64_t largest) {
        const auto value = details.at(key).get<uint64_t>();
        if (value > largest) throw std::out_of_range(key);
        return value;
    };
    h.minor = static_cast<uint8_t>(number("minor_version", 4));
    h.point_format = static_cast<uint8_t>(number("point_format", 8));
    h.record_length = static_cast<uint16_t>(number("record_length", 0xffff));
    h.file_source_id = static_cast<uint16_t>(number("file_source_id", 0xffff));
    h.global_encoding = static_cast<uint16_t>(number("global_encoding", 0xffff));
    h.creation_day = static_cast<uint16_t>(number("creation_day", 0xffff));
    h.creation_year = static_cast<uint16_t>(number("creation_year", 0xffff));
    h.system_id = details.at("system_id").get<std::string>();
    h.software = details.at("software").get<std::string>();
    const auto guid = from_base64(details.at("guid").get<std::string>());
    if (!guid || guid->size() != h.guid.size()) throw std::out_of_range("guid");
    std::memcpy(h.guid.data(), guid->data(), h.guid.size());
    auto records = records_from_json(details.at("records"));
    if (!records) throw std::out_of_range("records");
    h.vlrs = std::move(*records);
    if (record_bytes(h.point_format) == 0 || h.record_length < record_bytes(h.point_format))
        throw std::out_of_range("point_format");
    return h;
} catch (const std::exception& error) {  // nlohmann's, and our own out_of_range
    return rejected(file, fmt::format("the LAS header kept with the points is damaged ({})", error.what()));
}

std::optional<Lattice> lattice_of(const ScanInfo& scan) try {
    const auto details = nlohmann::json::parse(scan.details);
    if (details.at("format") != "las") return std::nullopt;
    Lattice lattice;
    for (int axis = 0; axis < 3; ++axis) {
        lattice.scale[axis] = details.at("scale").at(static_cast<size_t>(axis)).get<double>();
        lattice.offset[axis] = details.at("offset").at(static_cast<size_t>(axis)).get<double>();
        if (lattice.scale[axis] == 0 || !usable(lattice.scale[axis]) || !usable(lattice.offset[axis]))
            return std::nullopt;
    }
    return lattice;
} catch (const std::exception&) {  // nlohmann's: the details of another format
    return std::nullopt;
}

}  // namespace lucarne::io::las

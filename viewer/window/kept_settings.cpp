#include "viewer/window/kept_settings.h"

#include "io/core/log.h"

namespace lucarne::viewer {

KeptSettings::~KeptSettings() {
    if (const auto saved = save_settings(current(), config_folder()); !saved)
        log::warn("{}", saved.error().line());
}

void KeptSettings::save() {
    writer_.push("the settings", [settings = current(), folder = config_folder()] {
        return save_settings(settings, folder);
    });
}

/// Returns the settings as the user has changed them.
Settings KeptSettings::current() const {
    Settings settings = model_.settings;
    settings.window = window_.size();
    settings.navigation = navigation_name(model_.view.navigation.mode());
    settings.side_bar = model_.view.side_bar;
    return settings;
}

}  // namespace lucarne::viewer

// Exists for the precompiled header alone.

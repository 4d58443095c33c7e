// Exists only for the precompiled header.

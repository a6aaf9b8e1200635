// gi_mode of gi.h.
const uint MODE_GLOBAL = 0u, MODE_DIRECT = 1u, MODE_INDIRECT = 2u;

//! force_map

//! Depth and disparity maps: PFM, OpenEXR, levels of grey.
#![no_main]

fuzz::target!(fuzz::captures::depth_map);

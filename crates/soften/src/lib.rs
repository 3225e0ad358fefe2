//! soften

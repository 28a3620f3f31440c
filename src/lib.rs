//! nearmiss

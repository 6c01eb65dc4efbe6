//! Components and resources that cross a stage boundary.

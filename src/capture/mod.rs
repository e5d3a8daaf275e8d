//! Frames of a line as files that other programs read, and such files as frames again.

//! What the frames of a line tell about its health, and what to do about it. Pure: it is fed with frames.

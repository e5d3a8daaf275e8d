//! The whole program on a simulated line with every fault in turn, watched for what must hold.

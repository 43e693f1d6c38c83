//! The experiments of the founding paper, run in simulation with the program's own code, each number beside the paper's.

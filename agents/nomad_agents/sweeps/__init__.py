"""Sweeps: a grid of options over seeds, on all processors or machines, into one Parquet file."""

"""Agents for nomad_mj, and what trains, evaluates and shows them."""

"""What is measured and drawn of agents: figures, speed."""

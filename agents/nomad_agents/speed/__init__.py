"""How fast everything is, and whether memory grows: what ``nomad-mj bench`` measures."""

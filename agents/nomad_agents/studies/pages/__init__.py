"""Pages of HTML that need no other file: a frame that all share, pictures, templates."""

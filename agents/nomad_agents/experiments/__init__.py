"""The paper's experiments over seeds, and all that is made of them."""

"""The command line, ``nomad-mj``: one file a command."""

"""The field's benchmark: agents on the same physical tasks, with the field's metrics."""

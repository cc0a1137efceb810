"""Tables and reports made of metrics, one file each."""

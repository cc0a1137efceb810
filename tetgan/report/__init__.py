"""Results as one HTML page that opens offline: tables, figures, solids, provenance."""

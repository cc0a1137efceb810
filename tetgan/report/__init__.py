"""The results as one page that opens offline: tables, figures, solids to turn and cut, provenance."""

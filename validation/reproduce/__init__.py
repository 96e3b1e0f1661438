"""The paper's claims, tables and figures by both models, and the report on them."""

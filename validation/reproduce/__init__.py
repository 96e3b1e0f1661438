"""The paper's claims, tables and figures by both models, and the report on them."""

ARTEFACTS = ("table1", "table2", "table3", "fig4", "fig5", "fig6", "fig7", "fig8")

"""Rules about robot files, and what they find. `registry.RULES` lists them all."""

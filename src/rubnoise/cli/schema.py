"""`rubnoise schema`: the JSON schema of scenario files."""


def command() -> None:
    """Print the JSON schema of scenario files, for editors that check and complete TOML.

    Example: rubnoise schema > scenarios/scenario.schema.json
    """
    import json

    from rubnoise.scenario import json_schema

    print(json.dumps(json_schema(), indent=2, ensure_ascii=False))

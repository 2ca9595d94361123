"""What tests share: FMUs made for them, instances, systems of known answer, tools of others."""

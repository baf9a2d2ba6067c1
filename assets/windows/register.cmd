@echo off
rem Tells Windows, for the current user only, that this Focus Brush opens its kinds of files.
rem Run it again after moving the folder; unregister.cmd takes it back.
setlocal
set "PROGRAM=%~dp0focus-brush-window.exe"
set "CLASSES=HKCU\Software\Classes"

reg add "%CLASSES%\FocusBrush.Project" /ve /d "Focus Brush project" /f >nul || goto failed
reg add "%CLASSES%\FocusBrush.Project\DefaultIcon" /ve /d "\"%PROGRAM%\",0" /f >nul || goto failed
reg add "%CLASSES%\FocusBrush.Project\shell\open\command" /ve /d "\"%PROGRAM%\" \"%%1\"" /f >nul || goto failed
reg add "%CLASSES%\.fbrush" /ve /d "FocusBrush.Project" /f >nul || goto failed

reg add "%CLASSES%\FocusBrush.Scene" /ve /d "3D scene" /f >nul || goto failed
reg add "%CLASSES%\FocusBrush.Scene\DefaultIcon" /ve /d "\"%PROGRAM%\",0" /f >nul || goto failed
reg add "%CLASSES%\FocusBrush.Scene\shell\open\command" /ve /d "\"%PROGRAM%\" \"%%1\"" /f >nul || goto failed
rem Scenes keep the program that opens them; Focus Brush is offered under "Open with".
reg add "%CLASSES%\.glb\OpenWithProgids" /v "FocusBrush.Scene" /d "" /f >nul || goto failed
reg add "%CLASSES%\.gltf\OpenWithProgids" /v "FocusBrush.Scene" /d "" /f >nul || goto failed

echo Projects (.fbrush) now open with "%PROGRAM%".
exit /b 0

:failed
echo The registry could not be written to.
exit /b 1
